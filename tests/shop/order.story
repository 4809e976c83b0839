#! An order of the shop from its arrival to the part: the operator accepts it, takes over its size and grinds.
kind gc
power on
key hydraulic
wait 4 s
home all
key 尾座进
wait 2 s
key 砂轮启动
wait 10 s
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
order accept 701 O1002 1 #521=39.95
expect message "701 已接受"
order start 701
mode auto
key 循环启动
expect state running
wait until idle max 200 s
expect part diameter at Z39 39.950 ±0.004
wait 20 s
