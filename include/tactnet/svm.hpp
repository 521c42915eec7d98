#pragma once

#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/folds.hpp>
#include <tactnet/svm/grid_search.hpp>
#include <tactnet/svm/kernel/cache.hpp>
#include <tactnet/svm/kernel/functions.hpp>
#include <tactnet/svm/kernel/gram_matrix.hpp>
#include <tactnet/svm/kernel/samples.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/svm/kernel_machine.hpp>
#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/linear_machine.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/svm/probability.hpp>
#include <tactnet/svm/solvers/coordinate_descent.hpp>
#include <tactnet/svm/solvers/sequential_minimal_optimisation.hpp>
#include <tactnet/svm/standardisation.hpp>
