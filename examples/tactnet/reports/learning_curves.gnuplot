# Loss and validation accuracy of a training, epoch by epoch.
stats ARG1 skip 1 using 4 nooutput
validated = exists("STATS_records") && STATS_records > 0
set multiplot layout 1,(validated ? 2 : 1) title ARG2
set xlabel "epoch"
set logscale y
set ylabel "loss"
if (validated) {
    plot ARG1 skip 1 using 1:2 with lines lw 1.5 dt 2 title "training", "" skip 1 using 1:3 with lines lw 1.5 title "validation"
    unset logscale y
    set ylabel "accuracy on validation images, %"
    set yrange [:100]
    plot ARG1 skip 1 using 1:(100 * column(4)) with lines lw 1.5 notitle
} else {
    plot ARG1 skip 1 using 1:2 with lines lw 1.5 title "training"
}
unset multiplot
