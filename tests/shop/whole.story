#! What clients of the network are held against: a part of 39.9985 mm (40 0/-0.005) with X at -61.5 and Z at -20, then an alarm
#! of each condition, raised and repaired. Programs: tests/shop/programs.
kind gc
power on
param P375 899
param P376 521
param P377 0
param P378 -0.005
param P333 51
param P334 52
key hydraulic
wait 4 s
home all
mode auto
load O3005
key cycle-start
wait until idle max 60 s
expect X -61.500 ±0.002
expect Z -20.000 ±0.002
wait 4 s
load O3001
key cycle-start
wait 0.5 s
key reset
load O3002
key cycle-start
wait 0.5 s
key reset
load O3003
key cycle-start
wait 0.5 s
key reset
fault drive-x
wait 0.5 s
fault drive-x off
key reset
home all
mode auto
load O3004
key cycle-start
wait 1 s
fault coolant-missing
wait 4 s
fault coolant-missing off
key reset
fault lubrication-missing
wait 6 s
fault lubrication-missing off
wait 0.5 s
key reset
fault pressure-loss
wait 2 s
fault pressure-loss off
wait 3 s
key reset
fault bus-silent 50
wait 1 s
key reset
input emergency-stop on
wait 0.5 s
input emergency-stop off
wait 0.5 s
key reset
wait 1 s
