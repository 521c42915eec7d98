# Warm and cold calls: a network a row. `calls` is the table that scripts/pictures makes of a result file of benchmark_cold.
load "style.gnuplot"
eval begin("cold", 640, 460)
set logscale x
set xrange [0.3:1.2e5]
set xtics ("1 µs" 1, "10 µs" 10, "100 µs" 1e2, "1 ms" 1e3, "10 ms" 1e4)
set xlabel "time per frame (log scale)"
set yrange [-0.6:10.6]
set ytics scale 0
set border 1
set lmargin 25
set rmargin 5
set tmargin 1
set bmargin 5
set key at graph 1.02, graph 0.42 right samplen 0.6
eval note("Single precision, one core, ".processor.". Cold: after 96 MB of other memory. kB: packed weights.")
array by = ["tactnet, warm", "oneDNN, warm", "tactnet, cold", "oneDNN, cold"]
array hue = [blue, purple, blue, purple]
array mark = [6, 2, 7, 5]
plot for [i = 1:4] calls using i + 2:0:yticlabels(strcol(1)." · ".strcol(2)." kB") \
    with points pt mark[i] ps 0.85 lw 2 lc rgb hue[i] title by[i]
