# Histograms of contact area and mean tactel on a rigid, a semi-rigid and a flexible sensor:
#
#     tactnet_compliance > compliance.csv
#     gnuplot -c compliance.gnuplot compliance.csv compliance.png
set terminal pngcairo size 1000,360 font "DejaVu Sans,10"
set output ARG2
set datafile separator ","
set multiplot layout 1,2 margins 0.065,0.985,0.15,0.9 spacing 0.08
array sensors = ["rigid", "semi-rigid", "flexible"]
array colours = ["#1d3f72", "#e07b39", "#7a2d6b"]
set style fill transparent solid 0.18 noborder
set border 3 lw 0.6
set tics scale 0.4 nomirror
set yrange [0:*]
set key top right reverse Left samplen 1.5
bin(value, width) = (floor(value / width) + 0.5) * width
set ylabel "images" offset 1.5
set xlabel "contact area: tactels of 1400 that show anything" offset 0,0.3
set boxwidth 40
plot for [s = 1:3] ARG1 skip 1 using (strcol(1) eq sensors[s] ? bin($4, 40) : NaN):(1) smooth frequency \
    with fillsteps lc rgb colours[s] notitle, \
    for [s = 1:3] ARG1 skip 1 using (strcol(1) eq sensors[s] ? bin($4, 40) : NaN):(1) smooth frequency \
    with steps lw 2 lc rgb colours[s] title sensors[s]
unset key
unset ylabel
set xlabel "mean tactel: counts of those" offset 0,0.3
set boxwidth 5
plot for [s = 1:3] ARG1 skip 1 using (strcol(1) eq sensors[s] ? bin($5, 5) : NaN):(1) smooth frequency \
    with fillsteps lc rgb colours[s] notitle, \
    for [s = 1:3] ARG1 skip 1 using (strcol(1) eq sensors[s] ? bin($5, 5) : NaN):(1) smooth frequency \
    with steps lw 2 lc rgb colours[s] notitle
