#! The demonstration for spectators, first part: a cylindrical grinder from power-on to a ground part.
kind gc
power cut
title "外圆磨床：从开机到磨好一根轴" "Cylindrical grinder: from power-on to a ground shaft"
wait 3.5 s
power on
page home
caption "页面下边一排说还缺什么：液压，回零 ……" "The strip at the foot says what is still missing: hydraulics, homing …"
wait 1 s
key 液压
wait 3 s
load O1002
home all
expect no alarm
caption "…… 尾座顶住工件，砂轮启动" "… the tailstock holds the part, the wheel starts"
key 尾座进
wait 1 s
key 砂轮启动
wait 4 s
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
wait 5 s
