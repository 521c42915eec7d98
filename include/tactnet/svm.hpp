#pragma once

#include <tactnet/svm/coordinate_descent.hpp>
#include <tactnet/svm/dual_solver.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/folds.hpp>
#include <tactnet/svm/gram_matrix.hpp>
#include <tactnet/svm/grid_search.hpp>
#include <tactnet/svm/kernel_cache.hpp>
#include <tactnet/svm/kernel_machine.hpp>
#include <tactnet/svm/kernel_samples.hpp>
#include <tactnet/svm/kernel_space.hpp>
#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/kernels.hpp>
#include <tactnet/svm/linear_machine.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/svm/probability.hpp>
#include <tactnet/svm/standardisation.hpp>
