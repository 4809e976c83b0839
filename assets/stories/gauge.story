#! Grinding to the gauge (O1004): feeds change at its signals, the size is the gauge's; a dead gauge is an alarm and the wheel
#! comes off the part (P7, K3.9).
kind gc
power on
key 液压
wait 4 s
load O1004
home all
key 尾座进
wait 2 s
page grinding
expect no alarm                  #! page text and picture are there
mode auto
key 循环启动
wait until X<40.35 max 90 s
expect output radial-gauge on
expect output wheel on
expect lamp oscillation on
expect input gauge-1 off
wait until X<40.05 max 60 s
expect input gauge-1 on
expect input gauge-4 off
wait until idle max 60 s
expect no alarm
expect no event
expect output radial-gauge off
expect part diameter at Z39 40.000 ±0.0015

#! The next part with a gauge that tells nothing: at the limit the wheel comes off, alarm 3094.
load O1004
fault gauge-dead
key 循环启动
wait until alarm max 200 s
expect alarm 3094
expect no event
expect X 40.9 ±0.2
