#! The magnet of the rotary-table grinder: what needs it, and what keeps it (K3.11).
kind ga
power on
key hydraulic
wait 4 s
#! Neither table nor wheel without it.
key table-rotation
expect alarm 187
expect output table-rotation off
key reset
key wheel-start
expect alarm 187
expect output wheel off
key reset
key magnetise
wait 1.2 s
expect lamp magnetise on
key table-rotation
expect output table-rotation on
key wheel-start
expect output wheel on
#! Nothing lets the part go while it turns.
key demagnetise
expect alarm 187
expect output magnetise on
expect output demagnetise off
key reset
expect output table-rotation off
key demagnetise
expect alarm 187
key reset
#! The emergency stop takes wheel and table, and leaves the part clamped.
key table-rotation
key emergency-stop
expect output wheel off
expect output table-rotation off
expect output magnetise on
expect output hydraulic on
key emergency-stop
key reset
key demagnetise
expect output demagnetise on
wait 6.2 s
expect output demagnetise off
expect output magnetise off
expect no alarm
