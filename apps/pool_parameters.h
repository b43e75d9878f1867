#pragma once

#include "apps/parameter_binder.h"

#include "coupling/balance.h"

namespace apps
{
  /** How REVs are spread over the ranks. */
  struct PoolParameters
  {
    coupling::BalanceRule balance;
    bool writes_costs = false; ///< costs.csv
  };

  /** Binds them in the subsection "REVs". */
  void bind_pool(ParameterBinder &binder, PoolParameters &pool);
} // namespace apps
