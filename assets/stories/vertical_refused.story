#! The vertical lathe-grinder: wrong values are named, nothing moves, and the wheel stands at the end.
kind vertical
power on
key 液压
wait 4 s
load VGRIND
home all
mode auto
set R5 = 1920
key 循环启动
wait until idle max 5 s
expect message "错误02:转速过低"
expect R62 2
expect output wheel off
expect machine X 0.000 ±0.002

set R5 = 0
set R7 = 36
key 循环启动
wait until idle max 5 s
expect message "错误01:转速过高"
expect R62 1

set R7 = 30
set R3 = 210                      #! less than R1
key 循环启动
wait until idle max 5 s
expect message "错误05"
expect R62 5
expect output wheel off

mdi MSG()
set R3 = 300
mdi G90 G0 X=R46-20
wait 0.5 s
expect X 680.000 ±0.002
mdi R1=R300
expect alarm "R300"
