#! The demonstration for spectators, second part: a batch with its trend, an alarm and its repair, dressing.
kind gc
power on
key 液压
wait 3 s
load O1002
home all
key 尾座进
wait 2 s
key 砂轮启动
wait 10 s
mode auto
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
load O1002
key 循环启动
wait until idle max 120 s
expect no alarm
page process
load O1002
prepared
title "一批零件：每一件的尺寸都看得见" "A batch: the size of every part is seen"
key 循环启动
wait 3 s
caption "工艺页：力、功率、烧伤余量，下面是每件的尺寸和公差" "The process page: forces, power, margin to burning, and below them each part's size within its limits"
wait 11 s
caption "液压失压：机床停，砂轮关，原因和办法写在上面" "Hydraulic pressure is lost: it stops, the wheel goes off, cause and remedy are told"
fault pressure-loss
wait until alarm max 5 s
expect alarm 180
expect output wheel off
page alarm
wait 5 s
caption "修好以后：复位，砂轮再启动" "Repaired: reset, and the wheel starts again"
fault pressure-loss off
wait 3 s
key 复位
wait 1 s
expect no alarm
key 砂轮启动
wait 4 s
load O1011
page dressing
caption "修整：砂轮磨耗、修整点、进给和走刀，都在一页" "Dressing: wear of the wheel, dressing point, infeed and passes, all on one page"
wait 2 s
mode auto
key 循环启动
expect state running
wait 9 s
