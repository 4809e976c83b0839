#! The demonstration for spectators, third part: a surface grinder.
kind gs
power on
key 液压
wait 4 s
home all
load O1007
key 充磁
wait 2 s
key 砂轮启动
wait 10 s
expect output wheel on
mode mdi
mdi G90 G00 Y22
wait until idle
mdi G00 X-30 Z-45
wait until idle
set #680 = 20.1
set #681 = 20.0
set #687 = 0.02
set #688 = 0.01
set #689 = 0.005
set #690 = 6000
set #691 = 20
set #692 = 2
set #693 = 1
mode auto
page position
prepared
title "平面磨床：同一个控制核心，另一台机床" "Surface grinder: the same control, another machine"
key 循环启动
expect state running
wait 3 s
caption "磁台吸住工件，砂轮才能转；面板的键随机床而变" "The magnet must hold the plate before the wheel may turn; the panel's keys follow the machine"
wait 8 s
page grinding
caption "值和图随程序而变：O1007 平面往复磨" "Values and drawing follow the program: O1007, surface grinding in strokes"
wait 4 s
