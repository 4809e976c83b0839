#! 超人 lathe: cold start, homing over the switches, tool to the start, a shaft with a thread, measured.
kind lathe
power on
mode home
home all
expect machine X 0 ±0.002
expect machine Z 0 ±0.002

#! The bar lies in the chuck; the program begins where its G92 says: X100 Z50.
load SHAFT
mdi G00X100Z50
wait until idle max 30 s
expect X 100 ±0.001
expect Z 50 ±0.001

#! The tools, then the path and what the tools would meet, before anything moves.
page tools
wait 1 s
page graphic
wait 1 s

#! The bar is drawn as it is cut.
mode auto
key cycle-start
wait 3 s
expect state running
expect lamp spindle-forward on
expect input station-1 on
wait until idle max 600 s
expect no alarm
expect no event
expect lamp spindle-stop on
expect output coolant off
expect X 100 ±0.001
expect Z 50 ±0.001

#! The step of 30, the neck, the root of the thread, the bar behind.
expect part diameter at Z-50 30 ±0.02
expect part diameter at Z-34 20 ±0.02
expect part diameter at Z-20 18.4 ±0.02
expect part diameter at Z-80 45 ±0.001
