#! The hydraulic pressure goes while the wheel grinds: alarm 180, the program stops, the wheel is off (K3.7).
kind gc
power on
key 液压
wait 4 s
load O1002
home all
key 尾座进
wait 2 s
mode auto
key 循环启动
wait until X<40.3 max 90 s
expect state running
expect output wheel on
fault pressure-loss
wait until alarm max 5 s
expect alarm 180
expect output wheel off
expect output hydraulic on
expect output tailstock on
key 循环启动                      #! refused while the alarm is there
expect state alarm
key 砂轮启动
expect output wheel off
fault pressure-loss off           #! the pump is repaired
wait 4 s
key 复位
wait 1 s
expect no alarm
key 砂轮启动
wait 10 s
expect output wheel on
expect no alarm
