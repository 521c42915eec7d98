#pragma once

#include <tactnet/training/divergence.hpp>
#include <tactnet/training/early_stopping.hpp>
#include <tactnet/training/epoch_images.hpp>
#include <tactnet/training/evaluate.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/labelled_images.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/metrics.hpp>
#include <tactnet/training/optimiser.hpp>
#include <tactnet/training/progress.hpp>
#include <tactnet/training/recipe.hpp>
#include <tactnet/training/schedule.hpp>
#include <tactnet/training/split.hpp>
#include <tactnet/training/trainer.hpp>
