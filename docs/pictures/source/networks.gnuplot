# accuracy_and_time and latency. `study` and `inference` are the tables that scripts/pictures makes of docs/verify/study/study.csv and
# of benchmarks/results, `processor` is what they were measured on, `best_of_paper` an accuracy in percent.
load "style.gnuplot"

# Accuracy. Between 98 and 99 % half of the errors go, as between 80 and 90 %: the axis shows the errors on a logarithmic
# scale. A row: series, µs, accuracy, label, side of the point on which it stands.
eval begin("accuracy_and_time", 640, 460)
set nonlinear y via -log10(100.0 - y) inverse 100.0 - 10.0**(-y)
set yrange [90:99]
set ytics (90, 93, 95, 96, 97, 98, 98.5, 99)
set ylabel "test accuracy, % (errors on a log scale)"
set logscale x
set xrange [0.1:3e4]
set xtics ("1 µs" 1, "10 µs" 10, "100 µs" 1e2, "1 ms" 1e3, "10 ms" 1e4)
set xlabel "time per frame (log scale)"
set tmargin 1
set rmargin 2
set bmargin 5
unset key
eval note("One core, batch 1, ".processor.". Mean of 20 random splits of the paper's 1100 images.")
set label 1 sprintf("best of the paper: %.1f %%", best_of_paper) at 2.7e4,best_of_paper right offset 0,-0.7 tc rgb quiet font ",13"
set arrow 1 from 0.1,best_of_paper to 3e4,best_of_paper nohead lc rgb quiet dt (6,4)
set label 2 "Pareto front of tactnet" at 10.5,98.27 left offset 0.5,0 tc rgb blue
set label 3 "ImageNet-pretrained" at 2.7e4,97.85 right tc rgb orange
only(kind) = strcol(1) eq kind ? $2 : NaN
at(side) = strcol(5) eq side ? $2 : NaN
plot study using (only("front")):3 with linespoints pt 7 ps 0.9 lw 2 lc rgb blue, \
    "" using (only("other")):3 with points pt 6 ps 0.9 lw 2 lc rgb blue, \
    "" using (only("pretrained")):3 with points pt 5 ps 0.8 lc rgb orange, \
    "" using (only("oneDNN")):3 with points pt 2 ps 0.8 lw 2 lc rgb purple, \
    "" using (only("oneDNN")):3:4 with labels left offset 0.8,-0.15 tc rgb purple font ",13", \
    "" using (at("right")):3:4 with labels left offset 0.9,-0.15 tc rgb ink font ",13", \
    "" using (at("left")):3:4 with labels right offset -0.9,0.1 tc rgb ink font ",13", \
    "" using (at("under")):3:4 with labels center offset 1.5,-0.9 tc rgb ink font ",13", \
    "" using (at("above")):3:4 with labels center offset 0,0.8 tc rgb ink font ",13", \
    "" using (at("below")):3:4 with labels left offset -0.5,-1.1 tc rgb ink font ",13"
reset

# Latency: a network a row, what runs it in columns.
load "style.gnuplot"
eval begin("latency", 640, 460)
set logscale x
set xrange [0.2:3e4]
set xtics ("1 µs" 1, "10 µs" 10, "100 µs" 1e2, "1 ms" 1e3, "10 ms" 1e4)
set xlabel "time per frame (log scale)"
set yrange [-0.6:10.6]
set ytics scale 0
set border 1
set lmargin 25
set rmargin 4
set tmargin 6
set bmargin 5
unset key
eval note("One core, batch 1, ".processor."; batch norms folded. M: million multiply-adds.")
array by = ["tactnet, 8 bits", "tactnet", "oneDNN", "OpenCV", "PyTorch"]
array hue = [blue, blue, purple, orange, green]
array mark = [6, 7, 2, 5, 8]
last = 10 # the row on which the names stand
plot for [i = 1:5] inference using i + 2:0:yticlabels(strcol(1)." · ".strcol(2)." M") \
        with points pt mark[i] ps 0.85 lw 2 lc rgb hue[i], \
    for [i = 1:5] "" using i + 2:($0 == last ? $0 : NaN):(by[i]) \
        with labels left rotate by 65 offset 0.2,0.7 tc rgb hue[i] font ",14"
