#! A worn X screw: which way the wheel came decides where it stands, until the table of the play is in the control.
kind vertical
power on
load VGRIND
key 液压
wait 4 s
home all
fault worn-screw-x
mdi G90 G94 G0 X600
wait 3 s
expect X 600.000 ±0.002           #! the encoder sees nothing of it
screw X ../screws/worn_x.csv
expect message "补偿表"
wait 0.5 s
expect X 600.000 ±0.002
mdi G0 X620
mdi G0 X600
wait 3 s
expect X 600.000 ±0.002
power cut
wait 1 s
power on                          #! the table is kept
key 液压
wait 4 s
home all
mdi G90 G0 X600
wait 3 s
expect X 600.000 ±0.002
expect no alarm
