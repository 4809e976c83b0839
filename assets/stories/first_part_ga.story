#! Rotary-table grinder: from a cold start to a ring ground on the turning table, to the thickness gauge.
kind ga
power on
key 液压
wait 4 s
home all
expect machine Z 0.000 ±0.002
load O1010
key 充磁
wait 2 s
expect lamp magnetise on
key 砂轮启动
wait 10 s
expect output wheel on

page grinding
expect no alarm                  #! page text and picture are there
type #740 25.05
type #741 25.0
type #745 0.015
type #746 0.0025
type #747 0.001
type #748 600
type #749 2
type #750 60
type #751 1
mode auto
key 循环启动
expect state running
wait until Z<25.03 max 400 s
expect output table-rotation on
key 进给保持
wait until held max 3 s
wait 1 s
key 循环启动
wait until idle max 600 s
expect no alarm
expect no event
expect output wheel off
expect output table-rotation off
expect output magnetise on
expect part height at X45 Z0 25.000 ±0.003
expect part height at X95 Z0 25.000 ±0.003
expect part height at X145 Z0 25.000 ±0.003

#! The diamond beside the table takes 25 µm of radius from the wheel.
load O1014
key 循环启动
wait until idle max 900 s
expect no event
expect #828 0.025 ±0.0001
expect wear 1 Z -0.025 ±0.002
