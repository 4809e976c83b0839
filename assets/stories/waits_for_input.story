#! M80 waits for its input and says which; RESET ends the wait (K3.13).
kind gc
power on
key hydraulic
wait 4 s
home all
mdi M80
expect state waiting
expect message "输入口 13"
input user-1 on
wait until idle max 1 s
input user-1 off
mdi M89
expect state waiting
key reset
wait until idle max 1 s
expect no alarm
