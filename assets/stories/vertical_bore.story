#! The vertical lathe-grinder inside: a tapered bore of 500 at Z105, 1 degree narrower downwards, from stock 499.5.
#! The head is swivelled by R14, the wheel dressed along its own rim; it leaves the bore upwards before each dressing.
kind vertical
power on
key 液压
wait 4 s
home all

load VBORE
mode auto
page grinding
key 循环启动                      #! R20 is still that of the last ring: the wheel does not fit in
wait until idle max 5 s
expect message "错误06:砂轮进不了孔"
expect R62 6
expect output wheel off

sheet 2
type R18 500
type R20 499.5
type R25 0.05
type R42 0.1
type R43 0.01
type R14 -1
type R28 0.01                     #! half of the outside: the wheel lies on a longer arc and would burn the bore
sheet 1

key 循环启动
expect state running
wait until X<201 max 120 s        #! X = 499.4 − R3: above the bore, then down into it
wait until idle max 1500 s
expect no alarm
expect no event
expect output wheel off
expect output table-rotation off
expect R60 500.000
expect R3 299.85 ±0.002           #! five dressings of R36 = 0.03
#! 500 − 2 · (105 − z) · tan 1°
expect part diameter at Z66 498.6385 ±0.003
expect part diameter at Z90 499.4763 ±0.003
expect part diameter at Z114 500.3142 ±0.003
page position
