#! 超人 lathe: rapid into the bar is a crash that stops the machine; RESET and the drives come back.
kind lathe
power on
home all
load SHAFT
mdi G00X100Z50
wait until idle max 30 s
mdi M03
wait 3 s
mdi G00Z-20
wait until idle max 30 s
expect no event
mdi G00X30
wait until alarm max 10 s
expect event crash
expect alarm 104
