#include "dem/contact_network.h"
#include "dem/packing_file.h"
#include "dem/programme_check.h"
#include "dem/rev_snapshot.h"
#include "dem/wall_contacts.h"
#include "tests/support/memory_cases.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace
{
  using namespace dem;
  using namespace dem::cases;
  namespace fs = std::filesystem;

  /** A folder of its own for each test, gone at the end. */
  class WalledState : public testing::Test
  {
  protected:
    WalledState() { fs::create_directories(folder_); }
    ~WalledState() override { fs::remove_all(folder_); }

    std::string path(const std::string &name) const { return (folder_ / name).string(); }

    const fs::path folder_ = fs::temp_directory_path() / ("walled_state_" + std::to_string(getpid()));
  };

  /** Walls that rub, so that they remember something. */
  RevModel make_rubbing_model()
  {
    RevModel model;
    model.material.wall_friction = 0.3;
    return model;
  }

  const Rev &get_loaded_rev()
  {
    static const Rev loaded = [] {
      Rev rev = make_rev(make_rubbing_model(), get_walled_packing().state);
      rev.control(make_oedometer(1e6));
      rev.accept();
      rev.commit();
      return rev;
    }();
    return loaded;
  }

  std::size_t count_wall_memories(const RevState &state)
  {
    return static_cast<std::size_t>(
        std::count_if(state.contacts.begin(), state.contacts.end(),
                      [](const ContactMemory &memory) { return is_wall(memory.b) && memory.shear_force.norm() > 0.; }));
  }

  /** Axial stresses of a box at rest [Pa], tension-positive. */
  struct AxialStresses
  {
    double on_walls = 0.;
    double friction = 0.;   ///< what the friction on the side walls adds to Love-Weber stress
    double limit = 0.;      ///< of its size: all side walls slide, each half towards its end
    double unbalanced = 0.; ///< what is out of balance may add
  };

  AxialStresses compute_axial_stresses(const RevState &state, const ContactLaw &law)
  {
    const auto contacts = list_contacts(state, law);
    const double height = state.cell.edges(2, 2), volume = state.cell.compute_volume();
    AxialStresses stresses;
    stresses.on_walls = compute_wall_stress(state.cell, contacts).z();
    double mean_force = 0.;
    for (const Contact &contact : contacts)
      {
        mean_force += contact.normal_force / static_cast<double>(contacts.size());
        if (!is_wall(contact.b) || get_axis(to_wall(contact.b)) == 2)
          continue;
        const double above_middle = (state.grains.place[contact.a].z - 0.5) * height;
        stresses.friction += above_middle * contact.shear_force.z() / volume;
        stresses.limit += std::abs(above_middle) * law.wall_friction * contact.normal_force / volume;
      }
    const double resultants = static_cast<double>(state.grains.size()) * state.unbalanced_ratio * mean_force;
    stresses.unbalanced = 0.5 * resultants * height / volume;
    return stresses;
  }

  TEST_F(WalledState, ServoGoesByTheWallsAndTheirFrictionIsTheDifference)
  {
    // Law: docs/theory.md Eq. 2.16: the axial wall bears its target within 0.2 %; Love-Weber stress differs by the
    // friction on the side walls, and by what is out of balance. Side walls stretch with the cell, so that a packing
    // does not slide along them on the whole: friction is what chance leaves of it, see below for more.
    const RevState &state = get_loaded_rev().get_committed();
    const AxialStresses stresses = compute_axial_stresses(state, get_loaded_rev().get_law());
    EXPECT_NEAR(stresses.on_walls, -1e6, 2e-3 * 1e6);
    EXPECT_NEAR(state.stress(2, 2), stresses.on_walls + stresses.friction, stresses.unbalanced);
  }

  /** Four layers of 3 x 3 grains squeezed between the side walls; they do not reach the walls below and above. */
  RevState make_layers(const double gap)
  {
    constexpr double squeezed = 3e-6; // off the width of three grains: two contacts and two walls [m]
    const double width = 6. * radius - squeezed, height = 8. * radius + 2. * gap;
    RevState state = make_state(std::vector<Vector>(36, Vector::Zero()), width);
    state.cell.kind = CellKind::rigid;
    state.cell.edges(2, 2) = height;
    for (int i = 0; i < 36; ++i)
      state.grains.place[i] = {(i % 3 + 0.5) / 3., (i / 3 % 3 + 0.5) / 3., (gap + (2 * (i / 9) + 1) * radius) / height,
                               radius};
    return state;
  }

  TEST_F(WalledState, LayersThatSlideAlongTheWallsFeelTheirFrictionInFull)
  {
    // Law: the same where sliding is certain: side walls follow the ends of the box past layers that the ends have yet
    // to reach, by 1/8 and 3/8 of twice the gap, many times what a contact bears before it slides (some 0.2 of its
    // overlap, 0.1 um). Friction then is mu N throughout, near 0.9 MPa of stress, and presses the layers; once the ends
    // push, layers follow them. Bounds: the limit, and half of it for layers that swing back when they are hit.
    for (const double gap : {1e-6, 3e-6, 10e-6})
      {
        Rev rev = make_rev(make_rubbing_model(), make_layers(gap));
        ASSERT_EQ(rev.control(make_oedometer(1e6)).status, RestStatus::at_rest);
        const RevState &state = rev.get_trial();
        const AxialStresses stresses = compute_axial_stresses(state, rev.get_law());
        EXPECT_NEAR(stresses.on_walls, -1e6, 2e-3 * 1e6);
        EXPECT_NEAR(state.stress(2, 2), stresses.on_walls + stresses.friction, stresses.unbalanced);
        EXPECT_LT(-stresses.friction, stresses.limit * (1. + 1e-9));
        EXPECT_GT(-stresses.friction, 0.5 * stresses.limit);
        EXPECT_GT(-stresses.friction, 0.1 * 1e6); // so that the second line tells
      }
  }

  TEST_F(WalledState, SnapshotKeepsEveryBit)
  {
    // Law: a box with what its walls remember comes back from a file as it was.
    const RevState &state = get_loaded_rev().get_committed();
    ASSERT_GT(count_wall_memories(state), 50u);
    write_snapshot(path("box.h5"), state, list_contacts(state, get_loaded_rev().get_law()), {});
    const RevState copy = read_snapshot(path("box.h5")).state;
    EXPECT_EQ(copy.cell.kind, CellKind::rigid);
    EXPECT_TRUE(are_equal_bits(copy, state));
  }

  TEST_F(WalledState, NetworkTakesOverWhatWallsRemember)
  {
    // Law: a network built anew goes on with the shear forces of the walls.
    const RevState &state = get_loaded_rev().get_committed();
    expect_same_memories(collect_memories(build_contact_network(state, 0.3 * radius)), state.contacts);
  }

  TEST_F(WalledState, ResumedRunKeepsEveryBit)
  {
    // Law: what is loaded on from the bytes of a state, or from its file, is what would have come without.
    Rev whole = get_loaded_rev();
    const RevState &state = whole.get_committed();
    write_snapshot(path("box.h5"), state, list_contacts(state, whole.get_law()), {});
    Rev from_bytes(whole.get_model(), deserialise(serialise(state)));
    Rev from_file(whole.get_model(), read_snapshot(path("box.h5")).state);
    for (Rev *const rev : {&whole, &from_bytes, &from_file})
      ASSERT_EQ(rev->control(make_oedometer(2e6)).status, RestStatus::at_rest);
    EXPECT_TRUE(are_equal_bits(from_bytes.get_trial(), whole.get_trial()));
    EXPECT_TRUE(are_equal_bits(from_file.get_trial(), whole.get_trial()));
  }

  TEST_F(WalledState, PeriodicStatesHaveNoWalls)
  {
    // Law: a wall as a partner is corrupt in a periodic cell, and so is a seventh wall in a box.
    RevState state = make_pair(1e-6, Vector::UnitX());
    state.add(ContactMemory{0, to_partner(0), Vector::Zero(), false});
    EXPECT_THROW(deserialise(serialise(state)), std::runtime_error);
    state.cell.kind = CellKind::rigid;
    EXPECT_EQ(deserialise(serialise(state)).contacts[0].b, to_partner(0));
    state.contacts[0].b = to_partner(n_walls);
    EXPECT_THROW(deserialise(serialise(state)), std::runtime_error);
  }

  TEST_F(WalledState, ReadsAPackingBetweenWalls)
  {
    // Law: a grain may reach beyond a wall by half its radius; more is named with its line and the wall.
    const auto read = [&](const double x) {
      std::ofstream(path("packing.txt")) << "# cell 1e-3 1e-3 1e-3\n5e-4 5e-4 5e-4 1e-4\n" << x << " 5e-4 5e-4 1e-4\n";
      return read_packing(path("packing.txt"), CellKind::rigid);
    };
    EXPECT_TRUE(read(0.5e-4 * (1. + 1e-9)).cell.has_walls());
    try
      {
        read(9.6e-4);
        FAIL();
      }
    catch (const std::runtime_error &error)
      {
        EXPECT_NE(std::string(error.what()).find("packing.txt:3"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("wall -2"), std::string::npos) << error.what();
      }
  }

  TEST_F(WalledState, ProgrammesDoNotShearThem)
  {
    // Law: walls follow three normal strains; a programme that asks for a shear strain contradicts them.
    LaboratoryStage stage;
    stage.kind = StageKind::strain_path;
    stage.strain = Vector(0.01, 0., 0.02).asDiagonal();
    EXPECT_NO_THROW(check_programme({stage}, CellKind::rigid));
    stage.strain(0, 1) = stage.strain(1, 0) = 1e-3;
    EXPECT_NO_THROW(check_programme({stage}, CellKind::periodic));
    try
      {
        check_programme({stage}, CellKind::rigid);
        FAIL();
      }
    catch (const StageContradiction &error)
      {
        EXPECT_EQ(error.quantity, "Strain");
        EXPECT_NE(std::string(error.what()).find("walls"), std::string::npos);
      }
  }
} // namespace
