#pragma once

#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/data/sample_batch.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/evaluate.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/loop.hpp>
#include <tactnet/training/loop/epoch_samples.hpp>
#include <tactnet/training/loop/progress.hpp>
#include <tactnet/training/loop/trainable.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/metrics.hpp>
#include <tactnet/training/optimiser.hpp>
#include <tactnet/training/recipe.hpp>
#include <tactnet/training/schedule.hpp>
#include <tactnet/training/trainer.hpp>
