# Two stages: the first one builds Lodeline, the second one holds the program and the libraries that it needs.
#
#   docker build -t lodeline .
#   docker run --rm -v "$PWD:/data" lodeline run dive.bag -o result
FROM debian:12 AS build
ENV DEBIAN_FRONTEND=noninteractive
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates git make \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
RUN make build && make package && mv build/release/lodeline_*.deb /lodeline.deb

FROM debian:12
ENV DEBIAN_FRONTEND=noninteractive
COPY --from=build /lodeline.deb /lodeline.deb
RUN apt-get update && apt-get install -y --no-install-recommends /lodeline.deb gnuplot-nox \
 && rm -rf /var/lib/apt/lists/* /lodeline.deb
WORKDIR /data
ENTRYPOINT ["lodeline"]
CMD ["--help"]
