# Latency of one frame against multiply-adds, ours and the peers'. From a table of benchmark_inference:
#   gnuplot -e "table='benchmarks/results/PROCESSOR/DATE/inference.csv'; picture='docs/pictures/latency.png'" benchmarks/results/inference.gnuplot
set terminal pngcairo size 900,560 font "sans,11"
set output picture
set datafile separator ","
set logscale xy
set xlabel "multiply-adds on real pixels"
set ylabel "microseconds a frame, one core, batch 1"
set format x "10^{%L}"
set key top left
set grid
only(batch, value) = batch == 1 ? value : NaN
plot table using (only($2, $3)):6 every ::1 with points pt 9 ps 1.4 lc rgb "#b03030" title "oneDNN", \
     table using (only($2, $3)):4 every ::1 with points pt 7 ps 1.4 lc rgb "#2050a0" title "tactnet"
