#! What a browser is held against: a part of 39.9985 mm with X at -61.5, then an alarm that stays.
kind gc
power on
param P375 899
param P376 521
param P377 0
param P378 -0.005
param P334 52
key hydraulic
wait 4 s
home all
mode auto
load O3005
key cycle-start
wait until idle max 60 s
wait 1 s
fault lubrication-missing
wait 3600 s
