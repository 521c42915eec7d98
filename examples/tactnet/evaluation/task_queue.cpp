#include "evaluation/task_queue.hpp"

#include "reports/report.hpp"

task_queue::task_queue(const std::vector<task>& tasks, result_list& results)
    : results_(results), claims_((make_folder_of(results.claims_path()), results.claims_path())) {
    for (const task& t : tasks)
        left_.push_back(&t);
}

task_queue::answer task_queue::ask(const task*& next) {
    for (auto t = left_.begin(); t != left_.end();) {
        if (!claims_.take((*t)->settings)) {
            ++t;
            continue;
        }
        // Under the claim: another program may have finished it since the list was read.
        results_.read_on();
        next = *t;
        t = left_.erase(t);
        if (results_.find(next->settings) == nullptr)
            return answer::work;
        claims_.release(next->settings);
        ++from_others_;
    }
    return left_.empty() ? answer::nothing_left : answer::wait;
}
