# compliance: histograms of contact area and mean tactel on a rigid, a semi-rigid and a flexible sensor. `touches` is what
# tactnet_compliance prints.
load "style.gnuplot"
eval begin("compliance", 640, 330)
set multiplot layout 1,2 margins 0.1,0.985,0.19,0.84 spacing 0.1
array sensors = ["rigid", "semi-rigid", "flexible"]
array hue = [blue, orange, green]
array dashes = ["solid", "solid", "solid"]
set yrange [0:*]
set tics font ",13"
unset grid
set grid ytics lc rgb rule lw 1
bin(value, width) = (floor(value / width) + 0.5) * width
set ylabel "simulated touches" offset 1
set key at screen 0.53,0.99 center top horizontal maxrows 1
set xlabel "contact area, tactels of 1400" offset 0,0.3
set xtics 0, 300
plot for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($4, 40) : NaN):(1) smooth frequency \
    with fillsteps fs transparent solid 0.2 lc rgb hue[s] notitle, \
    for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($4, 40) : NaN):(1) smooth frequency \
    with steps lw 2 lc rgb hue[s] title sensors[s]
unset key
unset ylabel
set xlabel "mean count of the tactels in contact" offset 0,0.3
set xtics 0, 40
plot for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($5, 5) : NaN):(1) smooth frequency \
    with fillsteps fs transparent solid 0.2 lc rgb hue[s], \
    for [s = 1:3] touches skip 1 using (strcol(1) eq sensors[s] ? bin($5, 5) : NaN):(1) smooth frequency \
    with steps lw 2 lc rgb hue[s]
