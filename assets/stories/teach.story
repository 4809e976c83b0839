#! 超人 lathe: what is moved by hand becomes a program, which then does it by itself.
kind lathe
power on
home all
load SHAFT
mdi G00X100Z50
wait until idle max 30 s

#! Steps of 10 mm (P395), spindle and coolant by their keys.
page teach
expect page teach shows "未记录"
mode step
param P395 10
teach start
expect page teach shows "正在记录"
key z-minus
wait 1 s
key z-minus
wait 1 s
key spindle-forward
wait 3 s
key x-minus
wait 1 s
key coolant
wait 1 s
key x-plus
wait 1 s
key coolant
key spindle-stop
wait 2 s
teach stop
expect X 100 ±0.001
expect Z 30 ±0.001
expect page teach shows "N0010G92X100Z50"
expect page teach shows "N0020G01Z30"
expect page teach shows "N0030M03"
expect page teach shows "N0040G01X90"
expect page teach shows "N0050M07"

#! Nothing is recorded any more.
key x-plus
wait 1 s
expect X 110 ±0.001
teach undo
expect page teach shows "7 段"
