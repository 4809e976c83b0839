#! The demonstration for spectators: two minutes from power-on over a ground part, an alarm and its repair to the next part.
kind gc
power on
page home
caption "KT-830GC 外圆磨床数控：两分钟，从开机到磨好一根轴" "KT-830GC, a control for cylindrical grinders: two minutes from power-on to a ground shaft"
wait 4 s
caption "页面下边一排说还缺什么：液压，回零 ……" "The strip at the foot says what is still missing: hydraulics, homing …"
key 液压
wait 3 s
load O1002
home all
expect no alarm
caption "…… 尾座顶住工件，砂轮启动" "… the tailstock holds the part, the wheel starts"
key 尾座进
wait 2 s
key 砂轮启动
wait 6 s
page grinding
caption "磨削页：值和图在一起，碰一下图上的尺寸就能改" "The grinding page: values beside their drawing; touch a dimension to change it"
wait 5 s
mode auto
key 循环启动
expect state running
page position
caption "循环启动：机床按比例画出，切到时才有火花" "Cycle start: the machine is drawn to scale; sparks fly only while it cuts"
wait 9 s
caption "粗磨、精磨、无火花：上面的条说到了哪一步" "Roughing, finishing, spark-out: the bar tells how far it is"
wait until idle max 120 s
page grinding
caption "结果：尺寸、公差、循环时间；建议的修正一碰就取" "The result: size, tolerance, cycle time; a proposed correction is one touch away"
expect no alarm
expect part diameter at Z39 40.000 ±0.010
wait 6 s
caption "第二件中液压失压：停机，砂轮关，说出原因和办法" "Hydraulic pressure is lost in the second part: it stops, the wheel is off, cause and remedy are told"
key 循环启动
wait 9 s
fault pressure-loss
wait until alarm max 5 s
expect alarm 180
expect output wheel off
page alarm
wait 6 s
caption "修好以后：复位，砂轮再启动" "Repaired: reset, and the wheel starts again"
fault pressure-loss off
wait 4 s
key 复位
wait 1 s
expect no alarm
key 砂轮启动
wait 5 s
page process
caption "工艺页：力、功率、烧伤余量和每件的尺寸" "The process page: forces, power, margin to burning, the size of each part"
wait 5 s
page dressing
caption "修整页：砂轮磨耗、修整点和修整，都在一页" "The dressing page: wear of the wheel, dressing points and the dressing itself"
wait 6 s
page home
caption "触摸屏幕，自己试试" "Touch the screen and try it yourself"
wait 6 s
caption off
