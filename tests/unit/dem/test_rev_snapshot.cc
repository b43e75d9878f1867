#include "dem/rev_snapshot.h"

#include <sys/mount.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <unistd.h>

using dem::Contact;
using dem::RevState;

namespace
{
  namespace fs = std::filesystem;

  /** A folder of its own for each test, gone at the end. */
  class Snapshot : public testing::Test
  {
  protected:
    Snapshot()
    {
      fs::create_directories(folder_);
      std::mt19937_64 random(3);
      std::normal_distribution<double> normal;
      state_.cell.edges << 1.01, 0.1, 0.2, 0., 1.3, 0.3, 0.02, 0., 1.7;
      state_.cell.deformation << 1., 0.1, 0.2, 0.3, 1., 0.4, 0.5, 0.6, 1.;
      state_.rotation << 0., -1., 0., 1., 0., 0., 0., 0., 1.;
      state_.stress << 1., 2., 3., 4., 5., 6., 7., 8., 9.;
      state_.resize_grains(20);
      dem::Grains &g = state_.grains;
      for (std::size_t i = 0; i < g.size(); ++i)
        {
          for (dem::Column<dem::Row> *rows : {&g.place, &g.velocity, &g.spin})
            (*rows)[i] = {normal(random), normal(random), normal(random), std::exp(normal(random))};
          g.id[i] = 1000 - 7 * i; // neither in order nor the places
          g.parent[i] = 500 + i;
          g.generation[i] = static_cast<std::uint32_t>(i % 3);
          for (dem::Column<double> *list :
               {&g.strength, &g.crack_half_length, &g.crack_velocity, &g.largest_contact_stress})
            (*list)[i] = normal(random);
        }
      for (std::uint32_t i = 0; i < 19; ++i)
        {
          Contact contact;
          contact.a = i;
          contact.b = 19 - i;
          contact.branch = contact.normal = dem::Vector(normal(random), normal(random), normal(random)).normalized();
          contact.shear_force = {normal(random), normal(random), normal(random)};
          contact.overlap = 1e-7 * (i + 1);
          contact.normal_force = i;
          contact.is_sliding = i % 2 == 0;
          contacts_.push_back(contact);
          state_.add(dem::ContactMemory{contact.a, contact.b, contact.shear_force, contact.is_sliding});
        }
      state_.time = 12.5;
      state_.unbalanced_ratio = 3e-5;
      state_.initial_solid_volume = 0.7;
      state_.counters = {11, 22, 33, 2000};
    }

    ~Snapshot() override { fs::remove_all(folder_); }

    std::string path(const std::string &name) const { return (folder_ / name).string(); }

    void write(const std::string &name) const { dem::write_snapshot(path(name), state_, contacts_, {77, 5}); }

    fs::path folder_ = fs::temp_directory_path() / ("slowsand-test-" + std::to_string(::getpid()));
    RevState state_;
    std::vector<Contact> contacts_;
  };

  template <typename Action>
  std::string message_of(const Action &action)
  {
    try
      {
        action();
      }
    catch (const std::runtime_error &error)
      {
        return error.what();
      }
    return "no error";
  }

  std::string message_of_reading(const std::string &file)
  {
    return message_of([&] { dem::read_snapshot(file); });
  }

  bool contains(const std::string &text, const std::string &part)
  {
    return text.find(part) != std::string::npos;
  }

  std::vector<std::byte> make_bytes(const std::size_t n)
  {
    std::vector<std::byte> bytes(n);
    for (std::size_t i = 0; i < n; ++i)
      bytes[i] = static_cast<std::byte>(i * 31 + 7);
    return bytes;
  }

  /** No file of this process grows beyond a size while it lives: a full disk that needs no privileges. */
  class FileSizeLimit
  {
  public:
    explicit FileSizeLimit(const rlim_t size)
    {
      std::signal(SIGXFSZ, SIG_IGN);
      ::getrlimit(RLIMIT_FSIZE, &before_);
      const rlimit limit{size, before_.rlim_max};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }

  private:
    rlimit before_;
  };
} // namespace

// What is read is what was written, to the bit.
TEST_F(Snapshot, RoundTripKeepsEveryBit)
{
  write("a.h5");
  const dem::Snapshot copy = dem::read_snapshot(path("a.h5"));
  EXPECT_EQ(dem::serialise(copy.state), dem::serialise(state_)); // every field, see the test of the state
  EXPECT_EQ(copy.info.seed, 77u);
  EXPECT_EQ(copy.info.rev, 5u);
  EXPECT_FALSE(fs::exists(path("a.h5.tmp")));
}

// An empty packing is a packing: no grains, no contacts.
TEST_F(Snapshot, EmptyRoundTrip)
{
  dem::write_snapshot(path("a.h5"), RevState{}, {}, {});
  EXPECT_EQ(dem::read_snapshot(path("a.h5")).state.grains.size(), 0u);
}

// The names, units and shapes that scripts read are in the file, as another HDF5 program sees them.
TEST_F(Snapshot, NamesAndUnitsAreThePublishedOnes)
{
  write("a.h5");
  if (std::system("command -v h5dump > /dev/null") != 0)
    GTEST_SKIP() << "h5dump is not installed";
  const std::string list = path("list.txt");
  ASSERT_EQ(std::system(("h5dump -A " + path("a.h5") + " > " + list).c_str()), 0);
  std::ifstream stream(list);
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  for (const char *name : {"format",
                           "format_version",
                           "time_s",
                           "seed",
                           "matrix",
                           "kind",
                           "periodic",
                           "rotation",
                           "deformation",
                           "id",
                           "parent",
                           "generation",
                           "position",
                           "velocity",
                           "spin",
                           "radius",
                           "strength",
                           "crack_half_length",
                           "crack_velocity",
                           "largest_contact_stress",
                           "grain_a",
                           "grain_b",
                           "normal",
                           "overlap",
                           "normal_force",
                           "shear_force",
                           "is_sliding",
                           "stress",
                           "tension-positive",
                           "slowsand-rev"})
    EXPECT_TRUE(contains(text, std::string("\"") + name + "\"")) << name;
  std::size_t n_datasets = 0, n_units = 0;
  for (std::size_t at = 0; (at = text.find("DATASET \"", at)) != std::string::npos; ++at)
    ++n_datasets;
  for (std::size_t at = 0; (at = text.find("ATTRIBUTE \"unit\"", at)) != std::string::npos; ++at)
    ++n_units;
  EXPECT_EQ(n_datasets, 25u); // 4 matrices, 14 of grains, 7 of contacts
  EXPECT_EQ(n_units, n_datasets);
}

// A file that is missing, foreign or truncated is refused by name and cause.
TEST_F(Snapshot, RefusesFilesThatAreNone)
{
  EXPECT_TRUE(contains(message_of_reading(path("none.h5")), "none.h5: cannot open: No such file"));
  std::ofstream(path("text.h5")) << "x y z radius\n";
  EXPECT_TRUE(contains(message_of_reading(path("text.h5")), "text.h5: foreign: not an HDF5 file"));
  dem::create_file(path("other.h5"));
  EXPECT_TRUE(contains(message_of_reading(path("other.h5")), "attribute format: missing"));
  write("cut.h5");
  fs::resize_file(path("cut.h5"), fs::file_size(path("cut.h5")) / 2);
  EXPECT_TRUE(contains(message_of_reading(path("cut.h5")), "cut.h5: cannot open: truncated file"))
      << message_of_reading(path("cut.h5"));
}

// A dataset that is wrong in itself is named with what is wrong.
TEST_F(Snapshot, NamesTheDatasetThatIsInconsistent)
{
  state_.grains.place[4].w = 0.;
  write("radius.h5");
  EXPECT_TRUE(contains(message_of_reading(path("radius.h5")), "/grains/radius: grain 972")); // 1000 - 7 * 4
  state_.grains.place[4].w = 1.;
  state_.grains.id[3] = state_.grains.id[2];
  write("twice.h5");
  EXPECT_TRUE(contains(message_of_reading(path("twice.h5")), "/grains/id: grain 986 stands there twice"));
  state_.grains.id[3] = 1;
  write("replaced.h5"); // bytes in place of the numbers: another length
  dem::write_bytes(path("replaced.h5"), "/grains/strength", make_bytes(3));
  EXPECT_TRUE(contains(message_of_reading(path("replaced.h5")), "/grains/strength: wrong size, 3 by 1"));
  dem::write_bytes(path("replaced.h5"), "/contacts/grain_a", make_bytes(19));
  EXPECT_TRUE(contains(message_of_reading(path("replaced.h5")), "/grains/strength"));
  write("unknown.h5");
  dem::write_bytes(path("unknown.h5"), "/contacts/grain_b", make_bytes(19));
  EXPECT_TRUE(contains(message_of_reading(path("unknown.h5")), "/contacts/grain_b: unknown grain"));
}

// Bytes and texts come back as they went in; writing a name again replaces it.
TEST_F(Snapshot, BytesAndTexts)
{
  const std::string file = path("checkpoint.h5");
  dem::create_file(file);
  dem::write_bytes(file, "/revs/3/state", make_bytes(100000));
  dem::write_bytes(file, "/revs/4/state", {});
  dem::write_text(file, "/progress", "step 1");
  EXPECT_EQ(dem::read_bytes(file, "/revs/3/state"), make_bytes(100000));
  EXPECT_TRUE(dem::read_bytes(file, "/revs/4/state").empty());
  dem::write_bytes(file, "/revs/3/state", make_bytes(11));
  dem::write_text(file, "/progress", "step 2\nof 7");
  dem::write_text(file, "/nothing", "");
  EXPECT_EQ(dem::read_bytes(file, "/revs/3/state"), make_bytes(11));
  EXPECT_EQ(dem::read_text(file, "/progress"), "step 2\nof 7");
  EXPECT_EQ(dem::read_text(file, "/nothing"), "");
  EXPECT_TRUE(contains(message_of([&] { dem::read_bytes(file, "/revs/9/state"); }), "/revs/9/state: missing"));
  EXPECT_TRUE(contains(message_of([&] { dem::read_text(file, "/revs/3/state"); }), "/revs/3/state"));
}

// A flipped byte in a dataset of bytes is noticed.
TEST_F(Snapshot, BytesAreChecked)
{
  const std::string file = path("checkpoint.h5");
  dem::create_file(file);
  const std::vector<std::byte> bytes = make_bytes(4096);
  dem::write_bytes(file, "/state", bytes);
  std::string content;
  {
    std::ifstream stream(file, std::ios::binary);
    content.assign(std::istreambuf_iterator<char>(stream), {});
  }
  const std::size_t at = content.find(std::string(reinterpret_cast<const char *>(bytes.data()), 64));
  ASSERT_NE(at, std::string::npos);
  content[at + 10] ^= 1;
  std::ofstream(file, std::ios::binary) << content;
  EXPECT_TRUE(contains(message_of([&] { dem::read_bytes(file, "/state"); }), "/state: corrupted"));
}

// Writing into what is not an HDF5 file leaves it as it was.
TEST_F(Snapshot, ForeignFilesAreLeftAlone)
{
  std::ofstream(path("notes.txt")) << "mine";
  EXPECT_TRUE(contains(message_of([&] { dem::write_bytes(path("notes.txt"), "/x", make_bytes(9)); }), "foreign"));
  EXPECT_EQ(fs::file_size(path("notes.txt")), 4u);
  EXPECT_TRUE(contains(message_of([&] { dem::write_bytes(path("none.h5"), "/x", make_bytes(9)); }), "No such file"));
  EXPECT_FALSE(fs::exists(path("none.h5")));
  EXPECT_TRUE(contains(message_of([&] { write("nowhere/a.h5"); }), "nowhere/a.h5.tmp: cannot open: No such file"));
}

// Without room for the new file, path and cause are named and the old file stays whole; so does a half-written one.
TEST_F(Snapshot, NoRoomLeavesTheEarlierFile)
{
  write("a.h5");
  const std::vector<std::byte> before = dem::serialise(dem::read_snapshot(path("a.h5")).state);
  dem::create_file(path("b.h5"));
  dem::write_bytes(path("b.h5"), "/kept", make_bytes(1000));
  state_.time = 99.;
  {
    const FileSizeLimit limit(100 * 1024);
    const std::string message = message_of([&] { write("a.h5"); });
    EXPECT_TRUE(contains(message, "a.h5.tmp: cannot write: File too large")) << message;
    EXPECT_TRUE(contains(message_of([&] { dem::write_bytes(path("b.h5"), "/more", make_bytes(9)); }), "b.h5: cannot"));
  }
  EXPECT_EQ(dem::serialise(dem::read_snapshot(path("a.h5")).state), before);
  EXPECT_FALSE(fs::exists(path("a.h5.tmp")));
  EXPECT_EQ(dem::read_bytes(path("b.h5"), "/kept"), make_bytes(1000));
}

// The same on a disk that is really full.
TEST_F(Snapshot, FullDiskLeavesTheEarlierFile)
{
  const std::string disk = path("disk");
  fs::create_directories(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=1m") != 0)
    GTEST_SKIP() << "needs the right to mount a small disk";
  const std::shared_ptr<void> unmount(nullptr, [&](void *) { ::umount(disk.c_str()); });
  write("disk/a.h5");
  const std::vector<std::byte> before = dem::serialise(dem::read_snapshot(path("disk/a.h5")).state);
  std::ofstream(disk + "/filler") << std::string(1024 * 1024, 'x');
  state_.time = 99.;
  const std::string message = message_of([&] { write("disk/a.h5"); });
  EXPECT_TRUE(contains(message, "disk/a.h5.tmp: cannot write: No space left on device")) << message;
  EXPECT_EQ(dem::serialise(dem::read_snapshot(path("disk/a.h5")).state), before);
}

// A published file has its final name and takes the place of the one before.
TEST_F(Snapshot, PublishingRenames)
{
  dem::create_file(path("c.h5.tmp"));
  dem::write_text(path("c.h5.tmp"), "/progress", "new");
  std::ofstream(path("c.h5")) << "old";
  dem::publish_file(path("c.h5.tmp"), path("c.h5"));
  EXPECT_EQ(dem::read_text(path("c.h5"), "/progress"), "new");
  EXPECT_FALSE(fs::exists(path("c.h5.tmp")));
}
