#! Alarm 181: headstock and tailstock exclude each other, both ways (K3.3, K3.4).
kind gc
power on
key hydraulic
wait 4 s
#! The tailstock moves: the headstock may not start.
key tailstock-advance
key headstock-high
expect alarm 181
expect output headstock-high off
expect output tailstock on
key reset
expect no alarm
wait 2 s
#! The headstock turns: the tailstock may not move.
key headstock-low
expect output headstock-low on
key tailstock-retract
expect alarm 181
expect output tailstock on
#! Its remedy: RESET stops the headstock, then the tailstock goes.
key reset
expect output headstock-low off
key tailstock-retract
expect output tailstock off
expect no alarm
