# Before the scripts of a study's pictures: test accuracy against something else, in series by name.
set datafile columnheaders
x(i) = strcol("series") eq name[i] ? column("x") : NaN
stats ARG1 using (column("accuracy") - column("deviation")) nooutput
first = floor((STATS_min - 1) / 5) * 5
first = first < 0 ? 0 : first
stats ARG1 using "accuracy" nooutput
# Between 98 and 99 % half of all errors go, as between 80 and 90: the axis is stretched towards 100 %, so that halving
# the errors is the same height everywhere, unless something errs hardly at all.
last = STATS_max <= 99.4 ? 99.7 : 100
if (last < 100) {
    set nonlinear y via -log10(100.0 - y) inverse 100.0 - 10.0**(-y)
    set ytics (0, 20, 40, 50, 60, 70, 80, 90, 95, 97, 98, 99, 99.5)
}
below(y) = y > last ? last : y
stats ARG1 using "x" name "X" nooutput
set ylabel "test accuracy, %"
set key opaque bottom right
