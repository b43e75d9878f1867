#include "coupling/rev_model_text.h"

#include <gtest/gtest.h>

TEST(RevModelText, AReplayGetsTheModelThatFailed)
{
  // Law: what is read is what was written, to the last bit, also where it is not the default.
  dem::RevModel model;
  model.dynamics.precision = dem::Precision::single;
  model.dynamics.motion.local_damping = 1. / 3.;
  model.identity.rev = 17;
  const std::string text = coupling::write_model_text(model);
  const dem::RevModel read = coupling::read_model_text(text);
  EXPECT_EQ(coupling::write_model_text(read), text);
  EXPECT_EQ(read.dynamics.precision, dem::Precision::single);
  EXPECT_EQ(read.dynamics.motion.local_damping, 1. / 3.);
  EXPECT_EQ(read.identity.rev, 17u);
}
