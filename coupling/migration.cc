#include "coupling/migration.h"

#include <exception>

namespace coupling
{
  namespace
  {
    constexpr int tag = 73;

    /** Bytes of a REV, none if it cannot be packed. */
    std::vector<std::byte> try_to_pack(const Travel &travel, const PointId id, std::exception_ptr &failure)
    {
      try
        {
          return travel.pack(id);
        }
      catch (...)
        {
          failure = failure ? failure : std::current_exception();
          return {};
        }
    }

    std::vector<std::byte> receive_parcel(const int source, MPI_Comm communicator)
    {
      MPI_Status status;
      MPI_Probe(source, tag, communicator, &status);
      int size = 0;
      MPI_Get_count(&status, MPI_BYTE, &size);
      std::vector<std::byte> parcel(static_cast<std::size_t>(size));
      MPI_Recv(parcel.data(), size, MPI_BYTE, source, tag, communicator, MPI_STATUS_IGNORE);
      return parcel;
    }
  } // namespace

  std::uint64_t migrate(std::span<const Move> moves, std::span<const PointId> points, const Travel &travel,
                        MPI_Comm communicator)
  {
    const unsigned int here = dealii::Utilities::MPI::this_mpi_process(communicator);
    std::exception_ptr failure;
    std::vector<std::vector<std::byte>> parcels; // alive until they have been sent
    std::vector<MPI_Request> requests;
    std::uint64_t n_bytes = 0;
    parcels.reserve(moves.size());
    for (const Move &move : moves)
      if (move.from == here)
        {
          const std::vector<std::byte> &parcel = parcels.emplace_back(try_to_pack(travel, points[move.rev], failure));
          n_bytes += parcel.size();
          MPI_Isend(parcel.data(), static_cast<int>(parcel.size()), MPI_BYTE, static_cast<int>(move.to), tag,
                    communicator, &requests.emplace_back());
        }
    for (const Move &move : moves) // messages between two ranks arrive in the order of the moves
      if (move.to == here)
        try
          {
            const std::vector<std::byte> parcel = receive_parcel(static_cast<int>(move.from), communicator);
            if (!parcel.empty()) // else it could not leave: the other rank says why
              travel.unpack(points[move.rev], parcel);
          }
        catch (...)
          {
            failure = failure ? failure : std::current_exception();
          }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    n_bytes = dealii::Utilities::MPI::sum(n_bytes, communicator);
    if (failure)
      std::rethrow_exception(failure);
    return n_bytes;
  }
} // namespace coupling
