#! The vertical lathe-grinder: from a cold start to a ring ground to 200.000, the wheel dressed four times on the way.
kind vertical
power on
load VGRIND
mode auto
key 循环启动                      #! not homed: refused
expect alarm 100
key 复位

key 液压
wait 4 s
expect input hydraulic-pressure on
home all
expect machine X 0.000 ±0.002
expect machine Z 0.000 ±0.002

page grinding
sheet 2
type R18 200
type R20 200.5
type R25 0.05
type R42 0.1
sheet 1
expect R3 300

mode auto
key 循环启动
expect state running
wait 15 s
expect output wheel on
expect output table-rotation on
expect output coolant on
key 液压                          #! dead in a run
expect message "运行"
wait until X<502 max 120 s
key 进给保持
wait until held max 2 s
wait 2 s
key 循环启动
expect R3 299.97 ±0.002           #! after the first dressing: R36 less
wait until idle max 900 s
expect no alarm
expect no event
expect output wheel off
expect output table-rotation off
expect output coolant off
expect R60 200.000
expect R3 299.88 ±0.002           #! four dressings of R36 = 0.03
expect part diameter at Z66 200.000 ±0.002
expect part diameter at Z90 200.000 ±0.002
expect part diameter at Z114 200.000 ±0.002
page position
