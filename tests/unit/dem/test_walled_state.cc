#include "dem/contact_network.h"
#include "dem/packing_file.h"
#include "dem/programme_check.h"
#include "dem/snapshot.h"
#include "dem/wall_contacts.h"
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

  TEST_F(WalledState, ServoGoesByTheWallsAndTheirFrictionIsTheDifference)
  {
    // Law: docs/theory.md Eq. 2.16: the axial wall bears its target within 0.2 %; Love-Weber stress differs by the
    // friction on the side walls, and by what is out of balance.
    const RevState &state = get_loaded_rev().get_committed();
    const auto contacts = list_contacts(state, get_loaded_rev().get_law());
    const double on_walls = compute_wall_stress(state.cell, contacts).z(), volume = state.cell.compute_volume();
    EXPECT_NEAR(on_walls, -1e6, 2e-3 * 1e6);
    double friction = 0., mean_force = 0.;
    for (const Contact &contact : contacts)
      {
        mean_force += contact.normal_force / static_cast<double>(contacts.size());
        if (is_wall(contact.b) && get_axis(to_wall(contact.b)) != 2)
          friction +=
              (state.grains.place[contact.a].z - 0.5) * state.cell.edges(2, 2) * contact.shear_force.z() / volume;
      }
    const double resultants = static_cast<double>(state.grains.size()) * state.unbalanced_ratio * mean_force;
    const double unbalanced = 0.5 * resultants * state.cell.edges(2, 2) / volume;
    EXPECT_NEAR(state.stress(2, 2), on_walls + friction, unbalanced);
    // So that the line above tells friction: how large it is differs from machine to machine, as grains that slide do.
    EXPECT_GT(std::abs(friction), 10. * unbalanced);
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
    // Law: a network built anew goes on with the shear forces of the walls, in the same order.
    const RevState &state = get_loaded_rev().get_committed();
    const auto &expected = state.contacts;
    const auto again = collect_memories(build_contact_network(state, 0.3 * radius));
    ASSERT_EQ(again.size(), expected.size());
    for (std::size_t i = 0; i < again.size(); ++i)
      {
        EXPECT_EQ(again[i].a, expected[i].a);
        EXPECT_EQ(again[i].b, expected[i].b);
        EXPECT_EQ(again[i].shear_force, expected[i].shear_force);
        EXPECT_EQ(again[i].is_sliding, expected[i].is_sliding);
      }
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
    state.contacts.push_back({0, to_partner(0), Vector::Zero(), false});
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
