// Time of Pinocchio's aba, crba, rnea and nonLinearEffects, in nanoseconds per call, one line of JSON a robot.
//
// Arguments: models in Pinocchio's binary form (its wheel lacks the headers that its URDF reader needs). States in
// turn, calls and rounds as in benches/dynamics.rs; the best round counts. benches/peers/pinocchio_compare.py compiles
// and runs it.

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/serialization.hpp>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <limits>
#include <vector>

namespace {

constexpr int states = 64, calls = 512, rounds = 200;

// CPU time of this process, ns.
double now() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e9 * t.tv_sec + t.tv_nsec;
}

template <class Call> double nanoseconds(Call call) {
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const double start = now();
    for (int i = 0; i < calls; ++i)
      call(i % states);
    best = std::min(best, (now() - start) / calls);
  }
  return best;
}

} // namespace

int main(int argc, char **argv) {
  for (int a = 1; a < argc; ++a) {
    pinocchio::Model model;
    model.loadFromBinary(argv[a]);
    pinocchio::Data data(model);
    std::vector<Eigen::VectorXd> q, v;
    for (int i = 0; i < states; ++i) {
      q.push_back(pinocchio::integrate(model, pinocchio::neutral(model), Eigen::VectorXd::Random(model.nv)));
      v.push_back(Eigen::VectorXd::Random(model.nv));
    }
    const Eigen::VectorXd tau = Eigen::VectorXd::Random(model.nv), vdot = Eigen::VectorXd::Random(model.nv);
    // Both of its conventions; the faster one counts.
    double aba = std::numeric_limits<double>::infinity(), crba = aba;
    for (const auto convention : {pinocchio::Convention::LOCAL, pinocchio::Convention::WORLD}) {
      aba = std::min(aba, nanoseconds([&](int i) { pinocchio::aba(model, data, q[i], v[i], tau, convention); }));
      crba = std::min(crba, nanoseconds([&](int i) { pinocchio::crba(model, data, q[i], convention); }));
    }
    const double rnea = nanoseconds([&](int i) { pinocchio::rnea(model, data, q[i], v[i], vdot); });
    const double bias = nanoseconds([&](int i) { pinocchio::nonLinearEffects(model, data, q[i], v[i]); });
    std::printf("{\"nv\": %d, \"aba\": %g, \"crba\": %g, \"rnea\": %g, \"bias\": %g}\n", model.nv, aba, crba, rnea, bias);
  }
}
