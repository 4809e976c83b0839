#! 超人 lathe: what is moved by hand becomes a program, which then does it by itself.
kind lathe
power on
home all
load SHAFT
mdi G00X100Z50
wait until idle max 30 s

#! Steps of 10 mm (P395), spindle and coolant by their keys.
page teach
mode step
param P395 10
teach start
expect message "录返开始"
key z-minus
wait 1 s
key z-minus
wait 1 s
key spindle-forward
wait 3 s
key x-minus
wait 1 s
key coolant
wait 1 s
key x-plus
wait 1 s
key coolant
key spindle-stop
wait 2 s
teach stop
expect message "录返已停止"
expect X 100 ±0.001
expect Z 30 ±0.001

#! Nothing is recorded any more.
key x-plus
wait 1 s
expect X 110 ±0.001
teach undo

#! Another recording begins where the tool stands now; without a block there is nothing to keep.
teach start
teach keep
expect message "没有录返记录"
