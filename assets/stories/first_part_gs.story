#! Surface grinder: from a cold start to a plate ground on the magnet, to the thickness gauge.
kind gs
power on
key 循环启动
expect message "自动"
key 液压
wait 4 s
expect input hydraulic-pressure on
home all
expect machine Y 0.000 ±0.002

#! The magnet holds the plate before the wheel may start (K3.11).
key 砂轮启动
expect alarm 187
expect output wheel off
key 复位
load O1007
key 充磁
wait 2 s
key 砂轮启动
wait 10 s
expect output wheel on

#! The table to the left of the plate; then the values of the page.
mode mdi
mdi G90 G00 Y60
wait until idle
mdi G00 X-30 Z-45
wait until idle
page grinding
expect no alarm                  #! page text and picture are there
type #680 20.1
type #681 20.0
type #687 0.02
type #688 0.01
type #689 0.005
type #690 6000
type #691 20
type #692 2
type #693 1
#! A finished height above the stock is refused before anything moves.
type #681 20.2
mode auto
key 循环启动
expect alarm 3011
expect Y 60.000 ±0.002
key 复位
type #681 20.0
key 循环启动
expect state running
wait until Y<20.05 max 200 s
key 进给保持
wait until held max 3 s
wait 1 s
key 循环启动
wait until idle max 600 s
expect no alarm
expect no event
expect output wheel off
expect output magnetise on
expect Y 60.000 ±0.002
expect part height at X20 Z10 20.000 ±0.003
expect part height at X100 Z30 20.000 ±0.003
expect part height at X180 Z50 20.000 ±0.003

#! The wheel is dressed by the roll; the control knows how much smaller it is.
load O1013
key 循环启动
wait until idle max 120 s
expect no event
expect #806 0.030 ±0.0001
expect wear 1 Y -0.030
key 退磁
wait 7 s
expect output magnetise off
