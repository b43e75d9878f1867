#include "apps/pool_parameters.h"

namespace apps
{
  void bind_pool(ParameterBinder &binder, PoolParameters &pool)
  {
    binder.enter("REVs");
    binder.bind(
        "Move between ranks", pool.balance.is_active,
        "Idle ranks take waiting REVs over, and REVs migrate between steps so that their measured costs balance; "
        "false: they stay where they were dealt to. Results are the same, byte for byte. Units: none.");
    binder.bind("Smallest cost to move", pool.balance.smallest_cost, non_negative,
                "A REV whose next answer is expected to cost less is not taken over. Units: [s].");
    binder.bind("Balance tolerance", pool.balance.tolerance, non_negative,
                "Share by which the busiest rank may exceed the mean before REVs migrate. Units: [-].");
    binder.bind("Write costs", pool.writes_costs,
                "Whether to write costs.csv: what each REV cost in each step, and where it lived. Units: none.");
    binder.leave();
  }
} // namespace apps
