# compliance: histograms of contact area and mean tactel on a rigid, a semi-rigid and a flexible sensor. `touches` is what
# tactnet_compliance prints.
load "style.gnuplot"
eval begin("compliance", 640, 340)
set multiplot layout 1,2 margins 0.115,0.97,0.28,0.96 spacing 0.1
array sensors = ["rigid", "semi-rigid", "flexible"]
array hue = [blue, orange, green]
set yrange [0:*]
set tics font ",13"
unset grid
set grid ytics lc rgb rule lw 1
bin(value, width) = (floor(value / width) + 0.5) * width
set ylabel "touches" offset 0.5
set ytics 0, 50
unset key
eval note("1100 simulated touches of the paper's 22 classes on each sensor.")
set label 1 "rigid" at 230,205 tc rgb blue
set label 2 "semi-rigid" at 350,182 tc rgb orange
set label 3 "flexible" at 430,140 tc rgb green
set xlabel "contact area, tactels of 1400" offset 0,0.3
set xtics 0, 300
plot for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($4, 40) : NaN):(1) smooth frequency \
    with fillsteps fs transparent solid 0.2 lc rgb hue[s] notitle, \
    for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($4, 40) : NaN):(1) smooth frequency \
    with steps lw 2 lc rgb hue[s] notitle
unset for [i = 1:3] label i
unset ylabel
set xlabel "mean count in contact" offset 0,0.3
set xtics 0, 40
plot for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($5, 5) : NaN):(1) smooth frequency \
    with fillsteps fs transparent solid 0.2 lc rgb hue[s], \
    for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($5, 5) : NaN):(1) smooth frequency \
    with steps lw 2 lc rgb hue[s]
