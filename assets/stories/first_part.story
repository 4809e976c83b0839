#! From a cold start to a ground, measured part: what an operator does on the first morning.
kind gc
power on
expect state idle
key 循环启动
expect message "自动"
mode auto
load O1002
key 循环启动                     #! not homed: refused with alarm 100
expect alarm 100
expect machine X 0.000
expect output wheel off
key 复位
expect no alarm

key 液压
expect output hydraulic on
wait 4 s
expect input hydraulic-pressure on
expect no alarm

home all
expect machine X 0.000 ±0.002
expect machine Z 0.000 ±0.002

key 尾座进
wait 2 s
expect input tailstock-advanced on
key 砂轮启动
wait 10 s
expect output wheel on
expect lamp 砂轮启动 on

page grinding
type #520 40.3
type #521 40.0
type #522 60
type #523 29
type #524 0.4
type #525 0.05
type #526 1.2
type #527 0.3
type #528 6
type #529 1

mode auto
key 循环启动
expect state running
key 液压                          #! K2.2: dead in a run
expect output hydraulic on
expect message "运行"
key 冷却                          #! K2.2: coolant works in a run
wait until X<41 max 120 s
key 进给保持
wait until held max 2 s
wait 3 s
expect state held
key 循环启动
expect state running
wait until idle max 120 s
expect no alarm
expect no event
expect output wheel off
expect output headstock-high off
expect output coolant off
expect X 60.000 ±0.002
expect part diameter at Z39 40.000 ±0.004
