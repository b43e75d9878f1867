#include "dem/homogenisation.h"

#include "dem/walls.h"

#include <algorithm>
#include <numeric>

namespace dem
{
  Matrix compute_stress(const std::span<const Contact> contacts, const double volume)
  {
    Matrix sum = Matrix::Zero();
    for (const Contact &contact : contacts)
      sum += compute_force_on_a(contact) * contact.branch.transpose();
    return sum / volume;
  }

  Matrix compute_fabric(const std::span<const Contact> contacts)
  {
    Matrix sum = Matrix::Zero();
    for (const Contact &contact : contacts)
      sum += contact.normal * contact.normal.transpose();
    return contacts.empty() ? sum : Matrix(sum / static_cast<double>(contacts.size()));
  }

  CoordinationNumbers compute_coordination(const std::span<const Contact> contacts, const std::size_t n_grains,
                                           const bool is_rotation_free)
  {
    std::vector<std::size_t> n_contacts(n_grains, 0);
    for (const Contact &contact : contacts)
      {
        ++n_contacts[contact.a];
        if (!is_wall(contact.b))
          ++n_contacts[contact.b];
      }

    const std::size_t rattler_limit = is_rotation_free ? 4 : 3;
    CoordinationNumbers numbers;
    for (const std::size_t n : n_contacts)
      if (n < rattler_limit)
        ++numbers.n_rattlers;

    // The contacts of a rattler bear next to nothing, but they are counted: leaving them out would make new rattlers
    // of its neighbours, and the answer would depend on where that is stopped.
    const double n_ends = static_cast<double>(std::accumulate(n_contacts.begin(), n_contacts.end(), std::size_t(0)));
    if (n_grains > 0)
      numbers.all = n_ends / static_cast<double>(n_grains);
    if (n_grains > numbers.n_rattlers)
      numbers.without_rattlers = n_ends / static_cast<double>(n_grains - numbers.n_rattlers);
    return numbers;
  }
} // namespace dem
