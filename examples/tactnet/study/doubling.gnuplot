# After the name of an axis whose numbers double: accuracy and its deviation along it, a line for each series.
set logscale x 2
set xrange [0.8 * X_min:1.25 * X_max]
set xtics X_min, 2
set yrange [first:last]
plot for [i = 1:n] ARG1 using (x(i)):"accuracy" smooth unique with lines lw 1.5 lc i notitle, \
    for [i = 1:n] "" using (x(i)):"accuracy":(column("accuracy") - column("deviation")): \
        (below(column("accuracy") + column("deviation"))) with yerrorbars pt 4 + i % 10 ps 0.8 lc i title name[i]
