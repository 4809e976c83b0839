#! Alarm 180, hydraulic pressure missing: its five cases one after the other (K3.7).
kind gc
#! 1. After power-on: the pressure must be there P270 = 3 s later.
power on
wait 2.9 s
expect no alarm
wait 0.3 s
expect alarm 180
#! It blocks the wheel, not homing; and goes by itself when the pressure comes.
key wheel-start
expect output wheel off
key hydraulic
wait 4 s
expect no alarm
home all
#! M14 switches the pump on under the alarm, and pressure that goes because of M15 is none.
mdi M15
wait 4 s
expect no alarm
mdi M14
wait 4 s
expect no alarm
power on
wait 4 s
expect alarm 180
mdi M14
wait 4 s
expect no alarm

#! 2. After switching on: the pump runs, the pressure does not come. The delay begins anew with the pump.
power on
input hydraulic-pressure off
wait 1 s
key hydraulic
wait 2.8 s
expect no alarm
wait 0.3 s
expect alarm 180
input hydraulic-pressure on
wait 0.1 s
expect no alarm

#! 3. At the wheel's start: without the delay, or without the pump, there is no start.
input hydraulic-pressure off
key wheel-start
expect output wheel off
expect alarm 180
input hydraulic-pressure on
wait 0.1 s
expect no alarm
key wheel-start
expect output wheel on

#! 4. While the wheel runs: it stops with the filtered edge, and RESET is needed once the pressure is back.
input hydraulic-pressure off
expect output wheel off
expect alarm 180
input hydraulic-pressure on
wait 0.1 s
expect alarm 180
key reset
expect no alarm
expect output hydraulic on

#! 5. P270 = 0: the signal is not looked at, the wheel needs the pump only. P17.0 = 1: nothing is looked at.
param P270 0
input hydraulic-pressure off
wait 5 s
expect no alarm
key wheel-start
expect output wheel on
key wheel-stop
key hydraulic
key wheel-start
expect output wheel off
expect no alarm
expect message "液压"
param P270 3000
param P17.0 1
wait 5 s
expect no alarm
key wheel-start
expect output wheel on
expect no alarm
