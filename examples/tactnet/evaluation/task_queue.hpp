#pragma once

// The trainings that are left, given out so that no two programs on one folder of results do the same.

#include "evaluation/claims.hpp"
#include "evaluation/trainings.hpp"

#include <cstddef>
#include <list>
#include <vector>

class task_queue {
public:
    task_queue(const std::vector<task>& tasks, result_list& results);

    enum class answer { work, wait, nothing_left };
    /// What to do next: `next` is then this program's until `done`. To wait is for those that other programs
    /// do: their results are taken over when they are there, and what a program that ended has left undone is
    /// done here.
    answer ask(const task*& next);
    void done(const task& finished) { claims_.release(finished.settings); }

    std::size_t left() const { return left_.size(); }
    /// How many results other programs have brought.
    std::size_t from_others() const { return from_others_; }

private:
    std::list<const task*> left_;
    result_list& results_;
    training_claims claims_;
    std::size_t from_others_ = 0;
};
