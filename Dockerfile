# One image per service: docker build --build-arg SERVICE=mapper .
# SERVICE: perception, mapper, regions, retrieval, vlm_gateway or api.
# EXTRAS:  empty; `embedded` (small CPU models, pulled into the image) or `full` (GPU models) for perception.

FROM python:3.12-slim AS build
SHELL ["/bin/bash", "-o", "pipefail", "-c"]
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1
RUN python -m venv /opt/ovip
ENV PATH=/opt/ovip/bin:$PATH
WORKDIR /src

# The lock, where there is one, pins every dependency by hash; its layer is shared by all services.
COPY pyproject.toml requirements.lock* ./
RUN if [ -f requirements.lock ]; then pip install --require-hashes -r requirements.lock; fi

COPY . .
ARG EXTRAS=""
# hadolint ignore=DL3013
RUN pip install ".${EXTRAS:+[$EXTRAS]}"
RUN mkdir -p /opt/ovip/models \
    && if [ "$EXTRAS" = embedded ]; then OVIP_MODELS_DIR=/opt/ovip/models ovip models pull embedded; fi


FROM python:3.12-slim
ARG SERVICE
RUN test -n "$SERVICE" || { echo "build with --build-arg SERVICE=mapper, or another service" >&2; exit 1; } \
    && groupadd --gid 10001 ovip \
    && useradd --uid 10001 --gid ovip --no-create-home --home-dir /var/lib/ovip ovip \
    && install -d -o ovip -g ovip /var/lib/ovip /var/cache/ovip
COPY --from=build /opt/ovip /opt/ovip
ENV PATH=/opt/ovip/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    SERVICE=$SERVICE \
    OVIP_HOST=0.0.0.0 \
    OVIP_DATA_DIR=/var/lib/ovip \
    OVIP_MODELS_DIR=/opt/ovip/models \
    OVIP_LOG_JSON=true \
    HF_HOME=/var/cache/ovip
WORKDIR /var/lib/ovip
USER 10001:10001
EXPOSE 8080 50051 50052 50053 50054 50055

HEALTHCHECK --interval=5s --timeout=5s --start-period=90s --retries=6 \
    CMD ["sh", "-c", "case $SERVICE in \
        perception)  exec python -m ovip.healthcheck 127.0.0.1:${OVIP_PERCEPTION_PORT:-50051} ;; \
        mapper)      exec python -m ovip.healthcheck 127.0.0.1:${OVIP_MAPPER_PORT:-50052} ;; \
        regions)     exec python -m ovip.healthcheck 127.0.0.1:${OVIP_REGIONS_PORT:-50053} ;; \
        retrieval)   exec python -m ovip.healthcheck 127.0.0.1:${OVIP_RETRIEVAL_PORT:-50054} ;; \
        vlm_gateway) exec python -m ovip.healthcheck 127.0.0.1:${OVIP_VLM_GATEWAY_PORT:-50055} ;; \
        api)         exec python -m ovip.healthcheck http://127.0.0.1:${OVIP_API_PORT:-8080}/healthz ;; \
        *)           echo no such service: $SERVICE; exit 1 ;; \
        esac"]

CMD ["sh", "-c", "exec python -m services.${SERVICE}"]
