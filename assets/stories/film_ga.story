#! The demonstration for spectators, last part: a rotary-table grinder.
kind ga
power on
key 液压
wait 4 s
home all
load O1010
key 充磁
wait 2 s
key 砂轮启动
wait 10 s
expect output wheel on
set #740 = 25.05
set #741 = 25.0
set #745 = 0.015
set #746 = 0.0025
set #747 = 0.001
set #748 = 600
set #749 = 2
set #750 = 60
set #751 = 1
mode auto
page position
prepared
title "转台磨床：转台、磁台和砂轮互相联锁" "Rotary-table grinder: table, magnet and wheel are interlocked"
key 循环启动
expect state running
wait 3 s
caption "转台转、磁台吸，砂轮从上面磨一个环的平面" "The table turns, the magnet holds, the wheel grinds a ring's face from above"
wait 8 s
page home
title "触摸屏幕，自己试试" "Touch the screen and try it yourself"
wait 4 s
